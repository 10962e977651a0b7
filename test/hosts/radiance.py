"""Compares our reading of BSDF XML with Radiance and with WINDOW's parser.

The z axis of Radiance points to WINDOW's back, which is -z in our frame. The y axis points up in both programs.
Usage: radiance.py PROGRAM DATA, where DATA contains klems/ and tensor/.
"""
# needs: numpy pyradiance pywincalc
import os
import subprocess
import sys
import tempfile

import numpy as np
import pyradiance.bsdf as radiance
from support.checks import ROOT, arguments, expect, finish

program, data, _ = arguments()
# What is written: the tolerance of a transmittance, and the angles from which it is compared.
KLEMS = (1e-4, (0, 10, 30, 60, 120, 150))
WRITTEN = {"tensor/t3.xml": (0.02, (10, 30, 60)), "klems/2011-SA1.xml": KLEMS, "klems/klems_aniso_high.xml": KLEMS}


def direction(theta, phi):
    theta, phi = np.radians(theta), np.radians(phi)
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def values(path, pairs, folder, luminance=False):
    """f of the program at rows of Radiance's in and out: green, or the luminance."""
    from_radiance = np.array([-1, 1, -1, -1, 1, -1])
    np.savetxt(folder + "/p.csv", pairs * from_radiance, delimiter=",", header="wl_x,wl_y,wl_z,wv_x,wv_y,wv_z", comments="", fmt="%.9g")
    out = subprocess.run([program, "eval", path, "--pairs", folder + "/p.csv"], check=True, capture_output=True, text=True).stdout
    rgb = np.array([[float(x) for x in line.split(",")] for line in out.split()[1:]])[:, 6:9]
    return rgb @ [0.2126, 0.7152, 0.0722] if luminance else rgb[:, 1]


def transmittance(path, theta):
    """The value of Radiance for light from `theta`, in a process of its own, since other files may crash the module."""
    code = ("import sys, pyradiance.bsdf as b; print(b.direct_hemi(b.load_file(sys.argv[1]), float(sys.argv[2]), 0., "
            "b.SAMPLE_ALL & ~b.SAMPLE_R))")
    return float(subprocess.run([sys.executable, "-c", code, path, str(theta)], check=True, capture_output=True, text=True).stdout)


def is_read_by_window(path):
    code = "import sys, pywincalc; pywincalc.parse_bsdf_xml_file(sys.argv[1])"
    return subprocess.run([sys.executable, "-c", code, path], capture_output=True).returncode == 0


def tree_values(name, folder):
    path = f"{data}/tensor/{name}"
    bsdf, random, pairs, expected = radiance.load_file(path), np.random.default_rng(1), [], []
    for _ in range(3000):
        theta, phi = np.degrees(np.arccos(random.uniform(-1, 1, 2))), random.uniform(0, 360, 2)
        incoming, outgoing = map(direction, theta, phi)
        if incoming[2] < 0 and outgoing[2] < 0:
            continue  # reflection from WINDOW's front is in neither file: Radiance takes it for black
        pairs.append(np.r_[incoming, outgoing])
        expected.append(radiance.query(bsdf, theta[0], phi[0], theta[1], phi[1])[1])
    pairs, expected = np.reshape(pairs, (-1, 6)), np.array(expected)
    found = values(path, pairs, folder)
    # At the edge of a leaf the values of both sides are valid.
    agree = np.mean(np.abs(found - expected) <= 2e-4 * np.abs(expected) + 1e-5)
    expect(agree > 0.998, f"{name}: {agree:.4%} of {len(found)} directions have Radiance's value")


with tempfile.TemporaryDirectory() as folder:
    for name in ("t3.xml", "testBSDF.xml"):
        tree_values(name, folder)
    expect(abs(transmittance(f"{data}/tensor/t3.xml", 30) - 0.0764561) < 1e-6, "Radiance's transmittance of t3.xml at 30 degrees")
    written = {}
    for name in WRITTEN:
        written[name] = f"{folder}/{os.path.basename(name)}"
        subprocess.run([program, "convert", f"{data}/{name}", "--basis", "full", "-o", written[name]], check=True)
        expect(is_read_by_window(written[name]), f"{name}, written, is read by WINDOW's parser")
    for name, path in written.items():
        tolerance, thetas = WRITTEN[name]
        for theta in thetas:
            a, b = transmittance(f"{data}/{name}", theta), transmittance(path, theta)
            expect(abs(b - a) <= tolerance * a, f"{name} at {theta}: transmittance {a:.6f}, of what is written {b:.6f}")
    # Functions of models: luminances at random pairs, and the tree that bsdf2ttree makes of them.
    binaries = os.path.join(os.path.dirname(radiance.__file__), "bin")
    paper = ROOT / "data/paper_white_rgb.bsdf"
    for name, source, options in (("shade", f"{data}/klems/2011-SA1.xml", []), ("paper", paper, ["--lobes", "3"]),
                                  ("ggx", paper, ["--model", "ggx"])):
        model, cal = f"{folder}/{name}.srbf", f"{folder}/{name}.cal"
        subprocess.run([program, "fit", source, *options, "-o", model], check=True, capture_output=True)
        subprocess.run([program, "export", model, "--to", "radiance", "-o", cal], check=True)
        random = np.random.default_rng(2)
        pairs = random.normal(size=(400, 2, 3))
        if name != "shade":
            pairs[:, :, 2] = np.abs(pairs[:, :, 2])
        pairs = (pairs / np.linalg.norm(pairs, axis=2, keepdims=True)).reshape(-1, 6)
        rows = "\n".join(" ".join(f"{x:.9g}" for x in row) for row in pairs)
        out = subprocess.run([binaries + "/rcalc", "-f", cal, "-e", f"$1={name}($1,$2,$3,$4,$5,$6)"], input=rows, check=True,
                             capture_output=True, text=True).stdout
        expected = values(model, pairs if name == "shade" else pairs * np.array([-1, 1, -1, -1, 1, -1]), folder, luminance=True)
        error = np.abs(np.array(out.split(), float) - expected)
        mean = np.mean(error) / np.mean(expected)
        expect(np.max(error) <= 2e-3 * np.max(expected) and mean <= 1e-3, f"{name}.cal: values of the model, mean error {mean:.2e}")
        if name == "paper":
            tree = f"{folder}/{name}.tree.xml"
            with open(tree, "w") as file:
                subprocess.run([binaries + "/bsdf2ttree", "-p", "-t3", "-g", "4", "-f", cal, name], check=True, stdout=file)
            expect(len(open(tree).read()) > 10000, "bsdf2ttree makes a tree of paper.cal")
    # A tree becomes a model, and the model a matrix, which Radiance reads. The tree has steps: a model, and the matrix' patch
    # from 25 to 35 degrees, are nearer to its mean than to its value at 30.
    subprocess.run([program, "fit", f"{data}/tensor/t3.xml", "-o", f"{folder}/t3.srbf"], check=True, capture_output=True)
    subprocess.run([program, "convert", f"{folder}/t3.srbf", "-o", f"{folder}/t3.xml"], check=True)
    sines = np.sqrt(np.linspace(*np.sin(np.radians([25, 35])) ** 2, 21))
    mean = np.mean([transmittance(f"{data}/tensor/t3.xml", np.degrees(np.arcsin(sine))) for sine in sines])
    a = transmittance(f"{folder}/t3.xml", 30)
    expect(abs(a - mean) <= 0.02 * mean, f"t3.xml, fitted: transmittance at 30 degrees {a:.6f}, of the tree from 25 to 35 {mean:.6f}")
finish()
