"""Objects and executables: symbols, sizes, references and bytes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection


@dataclass(frozen=True)
class Symbol:
    """``address`` without the Thumb bit, ``size`` in bytes with the constants that stand behind a function."""

    address: int
    size: int
    kind: str


@dataclass(frozen=True)
class Image:
    """An ELF file."""

    path: Path

    @cached_property
    def _symbols(self) -> tuple[dict[str, Symbol], frozenset[str]]:
        defined, undefined = {}, set()
        with self.path.open("rb") as stream:
            for section in ELFFile(stream).iter_sections():
                for s in section.iter_symbols() if isinstance(section, SymbolTableSection) else ():
                    kind = s["st_info"]["type"]
                    if s["st_shndx"] == "SHN_UNDEF":
                        undefined.add(s.name)
                    elif kind in ("STT_FUNC", "STT_OBJECT"):
                        address = s["st_value"] & ~1 if kind == "STT_FUNC" else s["st_value"]
                        defined[s.name] = Symbol(address, s["st_size"], kind)
        return defined, frozenset(undefined - {""})

    @property
    def symbols(self) -> dict[str, Symbol]:
        """Return functions and objects, by name."""
        return self._symbols[0]

    @property
    def undefined(self) -> frozenset[str]:
        """Return the undefined symbols, as ``nm -u`` prints them."""
        return self._symbols[1]

    @cached_property
    def segments(self) -> tuple[tuple[int, bytes], ...]:
        """Yield (address, bytes) of every segment that is loaded."""
        with self.path.open("rb") as stream:
            every = ELFFile(stream).iter_segments()
            return tuple(
                (s["p_vaddr"], s.data()) for s in every if s["p_type"] == "PT_LOAD" and s["p_filesz"]
            )

    def sizes(self) -> dict[str, int]:
        """Return the sizes of the sections in flash or RAM [bytes], by name."""
        with self.path.open("rb") as stream:
            return {s.name: s["sh_size"] for s in ELFFile(stream).iter_sections() if s["sh_flags"] & 2}

    def content(self, name: str) -> bytes:
        """Return the bytes of an object that is loaded."""
        symbol = self.symbols[name]
        for start, data in self.segments:
            if start <= symbol.address < start + len(data):
                return data[symbol.address - start :][: symbol.size]
        raise KeyError(name)
