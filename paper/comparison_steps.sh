#!/bin/sh
# Makes the tables of docs/comparison.md again, from the clone's folder: paper/comparison_steps.sh RGL NBRDF NPS-BRDF WORK
#   RGL       the folder of RGL's five files
#   NBRDF     a folder with `merl_nbrdf` and `rgl-isotropic_nbrdf`, archives of https://github.com/asztr/Neural-BRDF
#   NPS-BRDF  the repository https://github.com/Rendering-at-ZJU/NPs-BRDF
#   WORK      an empty folder
# It needs Debian's pybind11-dev, python3-dev and python3-numpy, or with pip's NumPy 2 the package of `pip install .`.
set -eu
rgl=$1 nbrdf=$2 nps=$3 work=$4
python=/usr/bin/python3
export PYTHONPATH=build/release/python
./run build && cmake --preset release && cmake --build --preset release --target srbf_python
mkdir "$work/others" "$work/networks" "$work/rgl_networks" "$work/tables" "$work/merl35" "$work/nps"

# All 151 networks of NBRDF's authors, and the decoder and numbers of the neural process.
$python paper/convert_networks.py nbrdf "$nbrdf"/merl_nbrdf/*.h5 "$nbrdf"/rgl-isotropic_nbrdf/*.h5 "$work/others"
$python paper/convert_networks.py nps "$nps" "$work/nps"
# 49 networks stay in `networks`, and 97 in `others`.
for name in $(cut -d, -f1 docs/comparison.csv | sed 1d | sort -u); do mv "$work/others/$name.txt" "$work/networks"; done
for file in "$rgl"/*_rgb.bsdf; do mv "$work/networks/$(basename "$file" _rgb.bsdf).txt" "$work/rgl_networks"; done
$python paper/stand_ins.py "$work/networks" "$work/tables"
# 35 of MERL's 100 materials have a table.
for file in "$nbrdf"/merl_nbrdf/*.h5; do
    table=$work/tables/$(basename "$file" .h5).binary
    if [ -e "$table" ]; then cp "$table" "$work/merl35"; fi
done

$python paper/compare_models.py "$rgl"/*.bsdf "$work"/tables/*.binary --networks "$work/rgl_networks" --codes "$work/nps" \
    --tables "$work/merl35" >"$work/rows.csv"
cp "$work/rows.csv" docs/comparison.csv
python3 paper/comparison.py
# The 97 other materials, in four digits.
$python paper/stand_ins.py "$work/others" "$work/other_tables"
./run leaderboard "$work/other_tables"
cut -d, -f2,3,6,8-10 build/leaderboard/results.csv >docs/further_tables.csv
