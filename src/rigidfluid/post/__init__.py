"""Results become pictures, pages and movies; scenes are run and set side by side."""
