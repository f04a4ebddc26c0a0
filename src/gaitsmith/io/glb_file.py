"""What is in a GLB 2.0 file: its document, and the numbers that accessors tell of.

Only what motion needs is read: nodes, skins, animations. Meshes, textures and what extensions
add to them are left alone, whatever they hold.
"""

from __future__ import annotations

import base64
import binascii
import json
import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith.errors import FileFormatError

if TYPE_CHECKING:
    from pathlib import Path

    from jaxtyping import Float

#: Component types: NumPy's name, and what a normalized integer is divided by.
_COMPONENTS = {
    5120: ("i1", 127.0),
    5121: ("u1", 255.0),
    5122: ("<i2", 32767.0),
    5123: ("<u2", 65535.0),
    5125: ("<u4", 4294967295.0),
    5126: ("<f4", 1.0),
}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
#: Kinds of chunks.
_JSON, _BIN = b"JSON", b"BIN\0"
#: Data URIs of buffers begin so.
_DATA = "data:"
#: What goes wrong in data that are not as the specification wants them.
BROKEN = (LookupError, TypeError, ValueError, AttributeError, OverflowError, struct.error)


class GlbFile:
    """One file, read but for its numbers."""

    def __init__(self, path: Path) -> None:
        """Read the chunks; FileFormatError if they are none, OSError if it cannot be opened."""
        self.path = path
        data = path.read_bytes()
        if data[:4] != b"glTF":
            start = data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1]
            hint = "; it looks like a .gltf, which is text: export as GLB" if start == b"{" else ""
            raise self.error(f"not a GLB file: it does not begin with glTF{hint}")
        if len(data) < 20:
            raise self.error(f"ends after {len(data)} bytes, in its header")
        version, size = struct.unpack_from("<II", data, 4)
        if version != 2:
            raise self.error(f"is of glTF version {version}; version 2 is read, export it as that")
        if size > len(data):
            raise self.error(f"ends after {len(data)} of {size} bytes; it was cut off")
        self._binary: bytes | None = None
        text = self._chunks(data[:size])
        try:
            document = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise self.error(f"its JSON cannot be read: {' '.join(str(error).split())}") from None
        if not isinstance(document, dict):
            raise self.error("its JSON is no object")
        self.document: dict[str, Any] = document

    def error(self, what: str) -> FileFormatError:
        """The error of this file that says ``what``."""
        return FileFormatError(self.path, what)

    def _chunks(self, data: bytes) -> bytes:
        """The JSON chunk; keeps the first binary one."""
        text: bytes | None = None
        at = 12
        while at + 8 <= len(data):
            length, kind = struct.unpack_from("<I4s", data, at)
            body = data[at + 8 : at + 8 + length]
            if len(body) < length:
                raise self.error(f"its chunk at byte {at} ends after {len(body)} of {length} bytes")
            if text is None:
                if kind != _JSON:
                    raise self.error(f"its first chunk must be JSON, is {kind!r}")
                text = body
            elif kind == _BIN and self._binary is None:
                self._binary = body
            at += 8 + length
        if text is None:
            raise self.error("has no JSON chunk")
        return text

    def table(self, name: str) -> list[dict[str, Any]]:
        """The objects under ``name`` of the document; none if it has none."""
        found = self.document.get(name, [])
        if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
            raise self.error(f"{name} must be a list of objects")
        return found

    def item(self, name: str, index: object) -> dict[str, Any]:
        """Object ``index`` of the table ``name``."""
        table = self.table(name)
        if isinstance(index, bool) or not isinstance(index, int) or not 0 <= index < len(table):
            raise self.error(f"there is no {name}[{index!r}], there are {len(table)}")
        return table[index]

    def numbers(self, index: object) -> Float[np.ndarray, "n w"]:
        """Rows of an accessor, finite."""
        fact, named = self.item("accessors", index), f"accessors[{index}]"
        try:
            dtype, largest = _COMPONENTS[fact["componentType"]]
            width, count = _WIDTHS[fact["type"]], fact["count"]
        except (KeyError, TypeError) as error:
            raise self.error(f"{named} is of no kind that is read: {error}") from None
        if "sparse" in fact:
            raise self.error(f"{named} is sparse, which is not read; export without sparse data")
        if "bufferView" not in fact:
            return np.zeros((self._count(named, count, 0), width))
        view = self.item("bufferViews", fact["bufferView"])
        if "EXT_meshopt_compression" in view.get("extensions", {}):
            raise self.error(f"{named} is compressed by meshopt; export without compression")
        data = self._buffer(view.get("buffer"))
        unit = np.dtype(dtype).itemsize
        stride = view.get("byteStride", unit * width)
        first, size = view.get("byteOffset", 0), view["byteLength"]
        start = fact.get("byteOffset", 0)
        for what, value in (("byteStride", stride), ("byteOffset", first), ("byteOffset", start)):
            if isinstance(value, bool) or not isinstance(value, int) or value < 0:
                raise self.error(f"{named}: {what} must be a whole number of 0 or more")
        count = self._count(named, count, len(data))
        if not count:
            return np.zeros((0, width))
        last = start + (count - 1) * stride + unit * width
        if last > size or first + size > len(data):
            raise self.error(
                f"{named} reaches byte {first + last} of its buffer, which has {len(data)}"
            )
        rows = np.ndarray((count, width), dtype, data, first + start, (stride, unit))
        out = rows.astype(np.float64)
        if fact.get("normalized"):
            out = np.maximum(out / largest, -1.0)
        if not np.isfinite(out).all():
            row = int(np.argwhere(~np.isfinite(out))[0, 0])
            raise self.error(f"{named} must be finite, but row {row} is {out[row].tolist()}")
        return out

    def _count(self, named: str, count: object, most: int) -> int:
        if isinstance(count, bool) or not isinstance(count, int) or count < 0:
            raise self.error(f"{named}: count must be a whole number, got {count!r}")
        if count > max(most, 1_000_000):
            raise self.error(f"{named} has {count} rows, more than the file holds")
        return count

    def _buffer(self, index: object) -> bytes:
        """The bytes of a buffer: the binary chunk, or those in a data URI."""
        buffer = self.item("buffers", index)
        uri = buffer.get("uri")
        if uri is None:
            if self._binary is None or index != 0:
                raise self.error(f"buffers[{index}] is not in the file")
            return self._binary
        if isinstance(uri, str) and uri.startswith(_DATA) and ";base64," in uri:
            try:
                return base64.b64decode(uri.partition(";base64,")[2], validate=True)
            except (binascii.Error, ValueError) as error:
                raise self.error(f"buffers[{index}] is no base64: {error}") from None
        raise self.error(
            f"buffers[{index}] is in another file ({str(uri)[:60]!r}); export all into one GLB"
        )
