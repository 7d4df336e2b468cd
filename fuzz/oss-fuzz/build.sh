#!/bin/bash -eu
# Every target of fuzz/ with its kept corpus, files of the repository that it reads, and its dictionary.
cd "$SRC/moldloft"
cargo fuzz build -O --debug-assertions
for source in fuzz/fuzz_targets/*.rs; do
    name=$(basename "$source" .rs)
    cp "fuzz/target/x86_64-unknown-linux-gnu/release/$name" "$OUT/"
    zip -jqr "$OUT/${name}_seed_corpus.zip" "fuzz/corpus/$name"
    case $name in
        document | sdl_*) ending=sdl ;;
        model_file) ending=ms2 ;;
        sketch) ending=skt ;;
        *) continue ;;
    esac
    find examples tests/corpus -name "*.$ending" -size -17k -print | zip -jq "$OUT/${name}_seed_corpus.zip" -@
done
cp fuzz/dictionaries/sketch.dict "$OUT/sketch.dict"
# Names of kinds and functions, from the stubs.
for name in document expressions model_file sdl_format sdl_parse sdl_run; do
    sed -n 's/^def \([A-Za-z0-9_]*\)($/"\1"/p' python/moldloft/{kinds,functions}.pyi | sort -u > "$OUT/$name.dict"
done
for name in engine_messages lsp_frames; do
    cp fuzz/dictionaries/messages.dict "$OUT/$name.dict"
done
