"""Joints of an arm while it paints: limits, speeds and reach."""
