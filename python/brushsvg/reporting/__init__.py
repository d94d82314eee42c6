"""What all reports share: verdicts, short and long text, the worst places, and labels in pictures."""
