"""The quick pages, which `make pages` makes anew."""

QUICK = ("dfg_cylinder", "walls")
