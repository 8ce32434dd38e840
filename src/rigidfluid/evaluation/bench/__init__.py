"""Measurements that `rigidfluid bench` makes on the machine it runs on, beside published figures."""
