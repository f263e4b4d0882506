# The rigid-block analyses: one for each load, flow rule and combination of swept values; and the capacity curves of the stones.


rule rigid:
    input:
        code="code/rigid.txt",
        settings="rigid/{analysis}/settings.json",
        assemblage=lambda wildcards: f"geometry/{GEOMETRY_OF[wildcards.analysis]}/assemblage.npz",
        contacts=lambda wildcards: f"geometry/{GEOMETRY_OF[wildcards.analysis]}/contacts.npz",
    output:
        state="rigid/{analysis}/rigid.npz",
        record="rigid/{analysis}/rigid.json",
    log:
        "log/rigid/{analysis}.txt",
    benchmark:
        "benchmark/rigid/{analysis}.tsv"
    threads: SHARE
    resources:
        mem_mb=memory_by("fixed", 0.07),
    shell:
        STAGE + " rigid {wildcards.analysis:q} {input.settings:q} {input.assemblage:q} {input.contacts:q}"
        " {output.state:q} {output.record:q}" + LOG


rule curve:
    input:
        code="code/curve.txt",
        settings="curve/{analysis}/settings.json",
        assemblage=lambda wildcards: f"geometry/{GEOMETRY_OF[wildcards.analysis]}/assemblage.npz",
        contacts=lambda wildcards: f"geometry/{GEOMETRY_OF[wildcards.analysis]}/contacts.npz",
    output:
        state="curve/{analysis}/curve.npz",
        record="curve/{analysis}/curve.json",
    log:
        "log/curve/{analysis}.txt",
    benchmark:
        "benchmark/curve/{analysis}.tsv"
    threads: SHARE
    resources:
        mem_mb=memory_by("fixed", 0.07),
    shell:
        STAGE + " curve {wildcards.analysis:q} {input.settings:q} {input.assemblage:q} {input.contacts:q}"
        " {output.state:q} {output.record:q}" + LOG
