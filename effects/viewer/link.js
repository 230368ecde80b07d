// How a window talks with the viewer: by a WebSocket, or by a notebook's messages.
//
// Both give {open(handlers), send(message), close()}; handlers: said(message), picture(header, bytes), kept(name,
// bytes), linked(whether). A picture's message is eight bytes, whose first four are the length of its header, the
// header as JSON, and codes.

const AGAIN = [300, 600, 1200, 2500, 5000]; // milliseconds until the viewer is looked for again

function readPicture(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length)));
  return [header, new Uint8Array(buffer, 8 + length)];
}

async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Messages in their order: a file follows its name, and a deflated picture must not be overtaken.
function makeReader(handlers) {
  let file = null, last = Promise.resolve();
  async function read(message) {
    if (!(message instanceof ArrayBuffer)) {
      if (message.say === "kept") file = message;
      else handlers.said(message);
    } else if (file) {
      const { name, number } = file;
      file = null;
      handlers.kept(name, new Uint8Array(message), number);
    } else {
      const [header, bytes] = readPicture(message);
      handlers.picture(header, header.deflated ? await inflated(bytes) : bytes, message.byteLength);
    }
  }
  return (message) => {
    last = last.then(() => read(message)).catch((error) => console.error(error));
  };
}

function connectSocket(path) {
  let socket = null, tries = 0, isOver = false;
  return {
    open(handlers) {
      const connect = () => {
        const read = makeReader(handlers), opened = new WebSocket(`ws://${location.host}${path}`);
        socket = opened;
        opened.binaryType = "arraybuffer";
        opened.onopen = () => {
          tries = 0;
          handlers.linked(true);
        };
        opened.onmessage = ({ data }) => read(typeof data === "string" ? JSON.parse(data) : data);
        opened.onclose = ({ reason }) => {
          if (isOver) return;
          handlers.linked(false, reason);
          setTimeout(connect, AGAIN[Math.min(tries++, AGAIN.length - 1)]);
        };
      };
      connect();
    },
    send(message) {
      if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
    },
    close() {
      isOver = true;
      socket?.close();
    },
  };
}

function connectModel(model) {
  let heard = null;
  return {
    model,
    open(handlers) {
      const read = makeReader(handlers);
      heard = (message, buffers) => {
        if (message.say && message.say !== "picture") read(message);
        for (const { buffer, byteOffset, byteLength } of buffers || []) read(buffer.slice(byteOffset, byteOffset + byteLength));
      };
      model.on("msg:custom", heard);
      handlers.linked(true);
      model.send({ do: "hello" });
    },
    send: (message) => model.send(message),
    close: () => model.off("msg:custom", heard),
  };
}
