"""What an arm's joints do while it paints: where they put the flange, how far and fast they turn, where paper may lie."""
