"""Writing the equations of forms into the packaged tables again, after their text has changed.

`python -m coefficients.restate` does so. Nothing else in a table changes.
"""

from coefficients.catalogue import entries
from coefficients.files import write_whole
from coefficients.packaged import files
from coefficients.table import Table, read, serialise
from fitting import Form


def restated(table: Table, form: Form) -> Table:
    """Return a table with the equation of its form."""
    return table.model_copy(update={"equation": form.equation})


def restate() -> list[str]:
    """Write the equations into the packaged tables. Return the names of those that changed."""
    changed = []
    for entry in entries():
        if entry.name not in files():
            continue  # A published table as printed has the file of the published table.
        path = files()[entry.name]
        table = read(path)
        new = restated(table, entry.require_fitted().form)
        if new != table:
            write_whole(path, serialise(new))
            changed.append(entry.name)
    return changed


if __name__ == "__main__":
    print("\n".join(restate()) or "no equation changed")
