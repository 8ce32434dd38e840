"""A module for each page of docs/validation, with its function `page`; what several share begins with an underscore."""
