"""Report: what people read and see about a robot: text, figures and pages.

In comes a `Derivation`; out go Markdown, SVG and HTML. This room computes nothing that other rooms need.
"""
