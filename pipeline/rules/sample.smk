# A sample: all its stages in one process, for the records of its analyses. What it has in common with the building as it is
# is not made again.


rule sample:
    input:
        code="code/sample.txt",
        settings="sample/{sample}/settings.json",
        shared=config["sample"]["shared"] if config["sample"] else [],
    output:
        records="sample/{sample}/records.json",
    log:
        "log/sample/{sample}.txt",
    threads: 1
    params:
        drawing=config["drawing"] or "none",
    resources:
        mem_mb=MEMORY,
    shell:
        STAGE + " sample {wildcards.sample:q} {input.settings:q} {params.drawing:q} {output.records:q} {input.shared:q}" + LOG
