"""Values that were found right before are remembered, so that each is looked at once."""


class Remembered(dict):
    """Objects that were found right, by their identity and what else the finding depends on.

    By identity, because equal states may differ in what is checked (1, 1.0 and True are equal). An object is
    held as long as it is remembered, so its identity is nobody else's; all are forgotten when there are
    ``most``.
    """

    def __init__(self, most=4096):
        super().__init__()
        self.most = most

    def add(self, value, *beside, finding=True):
        """Remember that this value, beside these hashable ones, was found right; ``finding``: as what."""
        if len(self) >= self.most:
            self.clear()
        self[(id(value), *beside) if beside else id(value)] = value, finding
