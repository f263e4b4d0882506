# The rigid-block analyses: one for each load, flow rule and combination of swept values; the capacity curves of the stones, and supports that
# move.


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
    priority: priority_of
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
        first=lambda wildcards: [f"rigid/{name}/rigid.npz" for name in FIRST_OF[wildcards.analysis]],
    output:
        state="curve/{analysis}/curve.npz",
        record="curve/{analysis}/curve.json",
    log:
        "log/curve/{analysis}.txt",
    priority: LONGEST
    threads: SHARE
    resources:
        mem_mb=memory_by("fixed", 0.07),
    shell:
        STAGE + " curve {wildcards.analysis:q} {input.settings:q} {input.assemblage:q} {input.contacts:q}"
        " {output.state:q} {output.record:q} {input.first:q}" + LOG


rule halved:
    input:
        code="code/halved.txt",
        settings="curve/{analysis}/settings.json",
        assemblage=lambda wildcards: f"geometry/{GEOMETRY_OF[wildcards.analysis]}/assemblage.npz",
        contacts=lambda wildcards: f"geometry/{GEOMETRY_OF[wildcards.analysis]}/contacts.npz",
        first=lambda wildcards: [f"rigid/{name}/rigid.npz" for name in FIRST_OF[wildcards.analysis]],
    output:
        state="curve/{analysis}/halved.npz",
    log:
        "log/halved/{analysis}.txt",
    priority: LONGEST
    threads: SHARE
    resources:
        mem_mb=memory_by("fixed", 0.07),
    shell:
        STAGE + " halved {wildcards.analysis:q} {input.settings:q} {input.assemblage:q} {input.contacts:q}"
        " {output.state:q} {input.first:q}" + LOG


rule movement:
    input:
        code="code/movement.txt",
        settings="movement/{movement}/settings.json",
        tolerances=lambda wildcards: f"geometry/{MOVEMENTS[wildcards.movement]}/tolerances.json",
        assemblage=lambda wildcards: f"geometry/{MOVEMENTS[wildcards.movement]}/assemblage.npz",
        contacts=lambda wildcards: f"geometry/{MOVEMENTS[wildcards.movement]}/contacts.npz",
    output:
        cut="movement/{movement}/assemblage.npz",
        joints="movement/{movement}/contacts.npz",
        state="movement/{movement}/movement.npz",
        record="movement/{movement}/movement.json",
    log:
        "log/movement/{movement}.txt",
    priority: LONGEST
    threads: SHARE
    resources:
        mem_mb=memory_by("fixed", 0.07),
    shell:
        STAGE + " movement {wildcards.movement:q} {input.settings:q} {input.tolerances:q} {input.assemblage:q}"
        " {input.contacts:q} {output.cut:q} {output.joints:q} {output.state:q} {output.record:q}" + LOG
