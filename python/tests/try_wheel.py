"""What a wheel must do in an empty environment: scripts/wheel.sh runs it there."""

import subprocess
import sys
import time
from pathlib import Path

start = time.perf_counter()
import isoshell

took = time.perf_counter() - start
import numpy as np

corners = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], np.float32)
quads = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
result = isoshell.remesh((corners, quads), vertices=300, require="closed,genus=0,features")
assert result.vertices.shape == (300, 3)
with open("box.obj", "w") as file:
    file.writelines(f"v {x} {y} {z}\n" for x, y, z in corners)
    file.writelines("f " + " ".join(str(corner + 1) for corner in quad) + "\n" for quad in quads)
command = [sys.executable, "-m", "isoshell", "box.obj", "out.ply", "--vertices", "300", "--save-shell", "shell.vdb"]
subprocess.run(command, check=True)
assert isoshell.remesh("box.obj", vertices=300).digest == result.digest
assert isoshell.remesh("shell.vdb").vertices.shape == (300, 3)
subprocess.run([sys.executable, "-m", "isoshell", "info", "out.ply", "--require", "closed,genus=0"], check=True)
subprocess.run([Path(sys.executable).with_name("vdb_meshinfo"), "out.ply", "--quiet"], check=True)
share = Path(sys.prefix) / "share"
for page in ("man/man1/isoshell.1.gz", "bash-completion/completions/isoshell", "zsh/site-functions/_isoshell",
             "fish/vendor_completions.d/isoshell.fish"):
    assert (share / page).is_file(), page
print(f"Python {sys.version.split()[0]}: import {took:.3f} s, digest {result.digest}")
