"""The pages of the documentation, for the tests that read them."""
import os


def documents(folder):
    """Paths of all pages, relative to `folder`."""
    under = lambda where: sorted(os.path.relpath(os.path.join(at, name), folder)
                                 for at, _, names in os.walk(os.path.join(folder, where)) for name in names if name.endswith(".md"))
    return ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "data/README.md", *under("examples"), *under("docs"), *under("extras")]
