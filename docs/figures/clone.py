"""The folder of the clone. Importing this module makes the modules of test/ and paper/ importable, so it comes first."""
import os
import sys

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
sys.path[1:1] = [os.path.join(ROOT, "test"), os.path.join(ROOT, "paper")]
