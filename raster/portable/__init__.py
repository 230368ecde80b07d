"""The portable engine: plain loops, every state there is. A module for each stage; the other engines use the
same names.
"""
