"""Values that passed a check are remembered, so that each is checked once."""


class Remembered(dict):
    """Objects that passed a check, keyed by identity and by the values that the finding depends on.

    The key is the identity, because equal states may differ in what is checked (1, 1.0 and True are equal).
    The dictionary holds each object, so no other object gets its identity. It is emptied when it has ``most``
    entries.
    """

    def __init__(self, most=4096):
        super().__init__()
        self.most = most

    def add(self, value, *beside, finding=True):
        """Remember that this value, beside these hashable values, passed with this ``finding``."""
        if len(self) >= self.most:
            self.clear()
        self[(id(value), *beside) if beside else id(value)] = value, finding
