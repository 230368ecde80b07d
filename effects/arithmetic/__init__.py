"""The NV2A's arithmetic as rules, each with test vectors (docs/arithmetic-for-emulators.md)."""
