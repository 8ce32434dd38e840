"""What a user starts from: scenes that come with the package, and one of the user's own."""
