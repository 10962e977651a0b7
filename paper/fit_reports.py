"""Reports of `srbf fit`, several fits at a time."""
import concurrent.futures
import json
import os
import subprocess
import tempfile


def report_of_fit(program, path, *options, **environment):
    """Fits a measurement into temporary files and returns the report."""
    with tempfile.TemporaryDirectory() as work:
        report = os.path.join(work, "report.json")
        subprocess.run([program, "fit", path, "-o", os.path.join(work, "model.srbf"), "--json", report, "--threads", "1", *options],
                       env={**os.environ, **environment}, check=True, stdout=subprocess.DEVNULL)
        with open(report, encoding="utf-8") as file:
            return json.load(file)


def reports_of_fits(fit, arguments):
    """Yields each element of `arguments` and fit(*element), in order."""
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from zip(arguments, pool.map(lambda one: fit(*one), arguments))


def material_of(path):
    """Returns the name of a material from the path of its measurement."""
    return os.path.basename(path).removesuffix(".bsdf").removesuffix("_rgb")
