"""What an arm's joints do while it paints, how far and fast they turn, and where the paper may be for them."""
