"""Figures for print and animations."""
