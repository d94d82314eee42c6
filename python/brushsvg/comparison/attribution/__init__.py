"""The causes of errors: brush, machine or paper."""
