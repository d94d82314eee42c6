"""The motion that an inexact machine makes of a pass."""
