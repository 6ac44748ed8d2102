"""Tool surfaces for dd3imp from CAD, meshes and profiles; the command is utils/tool.py."""
