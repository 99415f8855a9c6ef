#!/usr/bin/env bash
# Draws a page that `trisect ... -o PAGE.html` wrote in a headless Chromium, without a network, and says whether it drew:
#   check.sh PAGE.html [PICTURE.png]
# Needs chromium and python3 with the package pillow. Not part of the tests.
set -euo pipefail
page=$(readlink -f "$1")
picture=$(readlink -m "${2:-/tmp/page.png}")
said=$(timeout 300 chromium --headless --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader \
    --disable-background-networking --host-resolver-rules='MAP * ~NOTFOUND' --no-first-run --enable-logging=stderr \
    --window-size=1000,700 --virtual-time-budget=10000 --screenshot="$picture" "file://$page" 2>&1 | grep CONSOLE || true)
python3 - "$picture" <<'PYTHON'
import sys
from PIL import Image
picture = Image.open(sys.argv[1]).convert("RGB")
left = picture.crop((0, 0, picture.width - 300, picture.height))
background = left.getpixel((2, 2))
drawn = sum(1 for pixel in left.getdata() if pixel != background)
print(f"{drawn} of {left.width * left.height} pixels are not background")
sys.exit(drawn < 1000)
PYTHON
if [[ -n $said ]]; then
    printf 'the console said:\n%s\n' "$said"
    exit 1
fi
echo "the console said nothing"
