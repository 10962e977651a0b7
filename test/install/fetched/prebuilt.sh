#!/bin/sh
# prebuilt.sh COMPILER ARGUMENT..: copies an object file of the library, or its compiled headers, from the build in $PREBUILT, and compiles others.
output= depfile= before=
for argument; do
  case $before in -o) output=$argument ;; -MF) depfile=$argument ;; esac
  before=$argument
done
object=$PREBUILT/CMakeFiles/${output#*/CMakeFiles/}
case $output in
  */CMakeFiles/srbf*.o | */CMakeFiles/srbf*.gch) echo "$output:" > "$depfile" && exec cp "$object" "$output" ;;
esac
exec "$@"
