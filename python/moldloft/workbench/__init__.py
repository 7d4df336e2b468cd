"""The workbench: interactive editing of a model in a browser.

``page <-> Server <-> Hub <-> Engine (a process of its own)``

The server speaks to browsers on this machine only; the hub has the text and is the one that says
what it is; the engine computes and may be lost at any time without loss of text.
"""
