"""HTML pages from the templates: text is escaped, a value that is missing is an error."""

from __future__ import annotations

from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

SHARED = "vista.report"  # whose templates hold what all pages include


def fill_template(template: str, package: str = SHARED, **values: Any) -> str:
    """The page of the package's templates/<template>; markup among the values comes as markupsafe.Markup."""
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader(SHARED)]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(template).render(values)
