"""Reports of `srbf fit`, several fits at a time."""
import concurrent.futures
import json
import os
import subprocess
import tempfile


def report(program, path, *options, **environment):
    """The report of a fit. Its files are temporary."""
    with tempfile.TemporaryDirectory() as work:
        written = os.path.join(work, "report.json")
        subprocess.run([program, "fit", path, "-o", os.path.join(work, "model.srbf"), "--json", written, "--threads", "1", *options],
                       env={**os.environ, **environment}, check=True, stdout=subprocess.DEVNULL)
        with open(written, encoding="utf-8") as file:
            return json.load(file)


def reports(fit, wanted):
    """Yields each element of `wanted` and fit(*element), in order."""
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from zip(wanted, pool.map(lambda one: fit(*one), wanted))


def material(path):
    return os.path.basename(path).removesuffix(".bsdf").removesuffix("_rgb")
