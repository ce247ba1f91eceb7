"""Messages of named numbers, for viewers that plot them: one protobuf schema for each set of names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorProto
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass

PACKAGE = "bfsim"
FRAME_FIELD = "frame"


class NumberMessages:
    """Makes messages `bfsim.KIND`: the index of the frame as `frame`, and a double for each number."""

    def __init__(self) -> None:
        self._pool = DescriptorPool()
        self._classes: dict[str, Any] = {}

    def message(self, kind: str, frame: int, numbers: Mapping[str, float]) -> Any:
        """Return a message; the first one of a kind determines the names of all."""
        if kind not in self._classes:
            self._classes[kind] = self._class(kind, numbers)
        return self._classes[kind](**{FRAME_FIELD: frame}, **numbers)

    def _class(self, kind: str, numbers: Mapping[str, float]) -> Any:
        file = FileDescriptorProto(name=f"{PACKAGE}/{kind}.proto", package=PACKAGE, syntax="proto3")
        described = file.message_type.add(name=kind)
        types = {FRAME_FIELD: FieldDescriptorProto.TYPE_UINT32} | dict.fromkeys(
            numbers, FieldDescriptorProto.TYPE_DOUBLE
        )
        for number, (name, type_) in enumerate(types.items(), start=1):
            described.field.add(
                name=name, number=number, type=type_, label=FieldDescriptorProto.LABEL_OPTIONAL
            )
        self._pool.Add(file)
        return GetMessageClass(self._pool.FindMessageTypeByName(f"{PACKAGE}.{kind}"))
