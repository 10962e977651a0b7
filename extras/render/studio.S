/* The bundled environment as a part of the program. */
    .section .rodata
    .global srbf_studio_begin, srbf_studio_end
    .balign 16
srbf_studio_begin:
    .incbin "data/studio.hdr"
srbf_studio_end:
    .byte 0
#if defined(__linux__) && defined(__ELF__)
    .section .note.GNU-stack, "", %progbits
#endif
