# Writes OUTPUT, a header that tells the SHA-256 of FILE.
file(SHA256 ${FILE} digest)
file(WRITE ${OUTPUT} "// ${digest}\n")
