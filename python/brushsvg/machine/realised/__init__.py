"""The true motion of an inexact machine, and commands that correct it."""
