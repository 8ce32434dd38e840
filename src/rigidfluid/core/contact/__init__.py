"""Contacts, from pairs of bodies to impulses."""
