#!/bin/bash -eu
# Every target of fuzz/ with its kept corpus and its dictionary.
cd "$SRC/moldloft"
cargo fuzz build -O --debug-assertions
for source in fuzz/fuzz_targets/*.rs; do
    name=$(basename "$source" .rs)
    cp "fuzz/target/x86_64-unknown-linux-gnu/release/$name" "$OUT/"
    if [ -d "fuzz/corpus/$name" ]; then
        zip -jqr "$OUT/${name}_seed_corpus.zip" "fuzz/corpus/$name"
    fi
done
cp fuzz/dictionaries/sketch.dict "$OUT/sketch.dict"
for name in engine_messages lsp_frames; do
    cp fuzz/dictionaries/messages.dict "$OUT/$name.dict"
done
