# From the case to stones and their contacts.

if config["drawing"]:

    rule drawing:
        input:
            code="code/drawing.txt",
            settings="geometry/{geometry}/settings.json",
        output:
            assemblage="geometry/{geometry}/assemblage.npz",
            vtu="geometry/{geometry}/stones.vtu",
        log:
            "log/drawing/{geometry}.txt",
        threads: 1
        params:
            # The settings hold its checksum. As an input, or as a plain text, braces in its name would be wildcards.
            drawing=lambda wildcards: config["drawing"],
        resources:
            mem_mb=MEMORY,
        shell:
            STAGE + " drawing {wildcards.geometry:q} {input.settings:q} {params.drawing:q} {output.assemblage:q} {output.vtu:q}" + LOG

else:

    rule source:
        input:
            code="code/source.txt",
            settings="geometry/{geometry}/settings.json",
        output:
            building="geometry/{geometry}/building.json",
        log:
            "log/source/{geometry}.txt",
        threads: 1
        resources:
            mem_mb=MEMORY,
        shell:
            STAGE + " source {wildcards.geometry:q} {input.settings:q} {output.building:q}" + LOG

    rule blocks:
        input:
            code="code/blocks.txt",
            building="geometry/{geometry}/building.json",
        output:
            assemblage="geometry/{geometry}/assemblage.npz",
            dxf="geometry/{geometry}/stones.dxf",
            vtu="geometry/{geometry}/stones.vtu",
        log:
            "log/blocks/{geometry}.txt",
        threads: 1
        resources:
            mem_mb=MEMORY,
        shell:
            STAGE + " blocks {wildcards.geometry:q} {input.building:q} {output.assemblage:q} {output.dxf:q} {output.vtu:q}" + LOG


rule contacts:
    input:
        code="code/contacts.txt",
        tolerances="geometry/{geometry}/tolerances.json",
        assemblage="geometry/{geometry}/assemblage.npz",
    output:
        contacts="geometry/{geometry}/contacts.npz",
    log:
        "log/contacts/{geometry}.txt",
    priority: WAITED_FOR
    threads: 1
    resources:
        mem_mb=memory_by("fixed", 0.07),
    shell:
        STAGE + " contacts {wildcards.geometry:q} {input.tolerances:q} {input.assemblage:q} {output.contacts:q}" + LOG
