"""The text of an SVG that Matplotlib wrote, cut to what a page needs: half of it, and the same picture."""

import re
from html import escape
from zlib import crc32


def slim(svg: str, prefix: str) -> str:
    """Ids that are referred to become ``prefix`` and a number, others go; a style that markers share stands once; few digits.

    ``prefix`` is no other picture's on the page.
    """
    used = dict.fromkeys(re.findall(r'(?:href="|url\()#([\w-]+)', svg))
    short = {old: f"{prefix}{number}" for number, old in enumerate(used)}
    svg = re.sub(r' ?\bid="([^"]*)"', lambda at: f' id="{short[at[1]]}"' if at[1] in short else "", svg)
    svg = re.sub(r'(?:xlink:)?(href="|url\()#([\w-]+)', lambda at: f"{at[1]}#{short[at[2]]}", svg)
    svg = re.sub(r"\s*\n\s*", " ", svg).replace("> <", "><")
    svg = re.sub(r"<g[^>]*>(?:<use [^>]*/>)+</g>", _hoisted, svg)
    svg = re.sub(r"<g>\s*</g>", "", svg)
    return re.sub(r'="[^"]*"', _digits, svg)


def labelled(svg: str, label: str) -> str:
    """With a text for readers who cannot see it."""
    return svg.replace('role="img"', f'role="img" aria-label="{escape(label)}"', 1)


def prefix_of(salt: str) -> str:
    """A beginning of ids from any words, those of strangers too."""
    return f"p{crc32(salt.encode()):08x}-"


def _hoisted(group: re.Match[str]) -> str:
    text = group[0]
    styles = set(re.findall(r'<use [^>]*?( style="[^"]*")', text))
    if len(styles) != 1:
        return text
    style = styles.pop()
    return text.replace(style, "").replace("<g", f"<g{style}", 1)


def _digits(value: re.Match[str]) -> str:
    kept = 1 if len(value[0]) > 300 else 2
    return re.sub(rf"(\d\.\d{{{kept}}})\d+", r"\1", value[0]).replace(" z ", "z").replace(" L ", "L").replace("M ", "M")
