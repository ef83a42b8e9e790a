"""Mechanism files: read and write TOML, report every problem with its line, JSON Schema."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.core.textfile.keys import (
        json_schema as json_schema,
        schema_of as schema_of,
        schema_text as schema_text,
    )
    from linkwork.core.textfile.link import (
        fragment_of as fragment_of,
        is_link as is_link,
        link_of as link_of,
        source_text as source_text,
        text_of_link as text_of_link,
    )
    from linkwork.core.textfile.reader import (
        ReadFile as ReadFile,
        read_bytes as read_bytes,
        read_file as read_file,
        read_text as read_text,
    )
    from linkwork.core.textfile.toml_text import Lines as Lines, bytes_of as bytes_of
    from linkwork.core.textfile.writer import (
        TextEdits as TextEdits,
        part_lines as part_lines,
        save as save,
        write_text as write_text,
    )
else:
    __getattr__ = loader(__name__)
