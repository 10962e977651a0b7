#!/bin/sh
# prebuilt.sh COMPILER ARGUMENT..: copies the object file that the build in $PREBUILT has, if it has it, and otherwise compiles.
output= depfile= before=
for argument; do
  case $before in -o) output=$argument ;; -MF) depfile=$argument ;; esac
  before=$argument
done
object=$PREBUILT/CMakeFiles/${output#*/CMakeFiles/}
case $output in
  */CMakeFiles/srbf*.o) if [ -f "$object" ]; then echo "$output:" > "$depfile" && exec cp "$object" "$output"; fi ;;
esac
exec "$@"
