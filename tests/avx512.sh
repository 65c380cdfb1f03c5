#!/usr/bin/env bash
# Runs unit tests in their AVX-512 code on any machine: in the emulator Bochs, under Debian's kernel.
#   ./run avx512 [PROGRAM [GTEST_FILTER]]    one test program, and which of its tests
# Built and installed already; everything is written to build/avx512. Status 1 if a test fails.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=$PWD/build/avx512 tests=build/release/tests
if (($# > 0)); then
    commands=("$1 --gtest_filter=${2:-*}")
else
    commands=(
        # What an emulator does in minutes: without statistics over millions of points.
        "test_shaders --gtest_filter=-Hash*:Noise.*:Turbulence*"
        "test_rays"
        "test_bake --gtest_filter=BlockLoops*:SurfaceBand*"
        "test_grids --gtest_filter=Levels*:BrickPyramid*-*OnEveryLevel"
    )
fi
for command in "${commands[@]}"; do
    if [[ ! -x "$tests/${command%% *}" ]]; then
        echo "avx512: no test program $tests/${command%% *}; there are: $(cd "$tests" && echo test_*)" >&2
        exit 2
    fi
done

# The kernel is taken out of its package, not installed.
kernel() {
    local package
    package=$(apt-cache depends linux-image-amd64 | sed -n 's/^ *Depends: //p' | head -1)
    if [[ ! -f "$out/$package" ]]; then
        (cd "$out" && apt-get download -qq -o APT::Sandbox::User=root "$package" && dpkg-deb -x "$package"_*.deb kernel &&
            rm "$package"_*.deb && cp "kernel/boot/vmlinuz-${package#linux-image-}" "$package" && rm -r kernel)
    fi
    echo "$out/$package"
}

# The test programs with all their libraries, and what starts them.
memory_disk() {
    local root=$out/root name library
    rm -rf "$root"
    mkdir -p "$root"/{bin,dev,proc,sys,tmp}
    cp /bin/busybox "$root/bin"
    for name in sh mount grep sleep poweroff; do ln -s busybox "$root/bin/$name"; done
    for name in "${commands[@]%% *}"; do
        cp "$tests/$name" "$root/bin"
        for library in $(ldd "$tests/$name" | grep -o '/[^ ]*'); do
            mkdir -p "$root$(dirname "$library")"
            cp -nL "$library" "$root$library"
        done
    done
    {
        echo "#!/bin/sh"
        echo "mount -t proc proc /proc; mount -t sysfs sys /sys; mount -t devtmpfs dev /dev; cd /tmp"
        echo "grep -q avx512vl /proc/cpuinfo || echo 'FAILED: no AVX-512'"
        for name in "${commands[@]}"; do echo "$name --gtest_color=no 2>&1"; done
        echo "echo 'all have run'; sleep 5; poweroff -f"  # 5: for the serial line to say it
    } >"$root/init"
    chmod +x "$root/init"
    (cd "$root" && find . | cpio --quiet -o -H newc | gzip -1)
}

mkdir -p "$out/disk/isolinux"
cp "$(kernel)" "$out/disk/vmlinuz"
memory_disk >"$out/disk/memory"
cp /usr/lib/ISOLINUX/isolinux.bin /usr/lib/syslinux/modules/bios/ldlinux.c32 "$out/disk/isolinux"
# Bochs 2.7 says another size of compacted registers than the kernel reckons, which then does without
# all of them: 321 and 323 are the features xsavec and xsaves.
cat >"$out/disk/isolinux/isolinux.cfg" <<'END'
default tests
label tests
 kernel /vmlinuz
 append initrd=/memory rdinit=/init console=ttyS0 quiet nosmp noapic mitigations=off clearcpuid=321,323 noxsaves
END
xorriso -as mkisofs -quiet -o "$out/disk.iso" -b isolinux/isolinux.bin -c isolinux/boot.cat -no-emul-boot \
    -boot-load-size 4 -boot-info-table "$out/disk" 2>"$out/xorriso.txt"
cat >"$out/bochsrc" <<END
megs: 2048
cpu: model=corei7_skylake_x, ips=200000000
ata0-master: type=cdrom, path=$out/disk.iso, status=inserted
boot: cdrom
com1: enabled=1, mode=file, dev=$out/result.txt
display_library: term
clock: sync=none
log: $out/bochs.txt
panic: action=report
error: action=report
END

rm -f "$out/result.txt" "$out/screen.txt"
touch "$out/result.txt"
mkfifo "$out/debugger" 2>/dev/null || true
TERM=xterm bochs -q -f "$out/bochsrc" <"$out/debugger" >"$out/screen.txt" 2>&1 &
emulator=$!
exec 3>"$out/debugger"
echo c >&3  # Debian's waits in its debugger
until screen=$(grep -ao '/dev/pts/[0-9]*' "$out/screen.txt"); do
    if ! kill -0 $emulator 2>/dev/null; then
        echo "avx512: the emulator does not start; what it said is in $out/screen.txt" >&2
        exit 1
    fi
    sleep 1
done
cat "$screen" >/dev/null 2>&1 &  # a screen that nobody reads stops the machine
reader=$!
tail -n +1 -f "$out/result.txt" &
shown=$!
trap 'kill -9 $emulator $reader $shown 2>/dev/null' EXIT
until grep -q 'all have run' "$out/result.txt"; do
    if ! kill -0 $emulator 2>/dev/null; then break; fi
    sleep 1
done
if ! grep -q 'all have run' "$out/result.txt" || grep -q 'FAILED' "$out/result.txt" ||
    (($(grep -c 'PASSED' "$out/result.txt") != ${#commands[@]})); then
    echo "avx512: not all tests passed: $out/result.txt" >&2
    exit 1
fi
