"""HTML pages from the templates: text is escaped, a value that is missing is an error."""

from __future__ import annotations

from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined


def fill_template(template: str, **values: Any) -> str:
    """The page of templates/<template>; markup among the values comes as markupsafe.Markup."""
    environment = Environment(
        loader=PackageLoader("vista"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(template).render(values)
