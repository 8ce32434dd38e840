"""Attacks on the program: hostile input, damage and kills, each tried where its end is contained."""
