"""Attribute errors to their causes: brush, machine or paper."""
