"""The words in which techniques write their passes."""
