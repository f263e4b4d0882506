# The homogenised shell: panels of a drawing, mesh, gate, and one limit analysis or capacity curve for each load and combination
# of swept values.

if config["drawing"]:

    rule panels:
        input:
            code="code/panels.txt",
            settings="geometry/{geometry}/settings.json",
            assemblage="geometry/{geometry}/assemblage.npz",
        output:
            building="geometry/{geometry}/building.json",
            fitted="geometry/{geometry}/fitted.npz",
            fit="geometry/{geometry}/fit.json",
        log:
            "log/panels/{geometry}.txt",
        threads: 1
        resources:
            mem_mb=memory_by("fixed", 0.07),
        shell:
            STAGE + " panels {wildcards.geometry:q} {input.settings:q} {input.assemblage:q} {output.building:q} {output.fitted:q}"
            " {output.fit:q}" + LOG


rule shell:
    input:
        code="code/shell.txt",
        settings="shell/{mesh}/settings.json",
        building=lambda wildcards: f"geometry/{SHELLS[wildcards.mesh]}/building.json",
    output:
        shell="shell/{mesh}/shell.npz",
    log:
        "log/shell/{mesh}.txt",
    priority: WAITED_FOR
    threads: 1
    resources:
        mem_mb=MEMORY,
    shell:
        STAGE + " shell {wildcards.mesh:q} {input.settings:q} {input.building:q} {output.shell:q}" + LOG


rule match:
    input:
        code="code/match.txt",
        shell="shell/{mesh}/shell.npz",
        carried="shell/{mesh}/carried.json",
        stones=lambda wildcards: f"geometry/{SHELLS[wildcards.mesh]}/{FITTED}",
        contacts=lambda wildcards: f"geometry/{SHELLS[wildcards.mesh]}/contacts.npz",
    output:
        match="shell/{mesh}/match.json",
    log:
        "log/match/{mesh}.txt",
    priority: WAITED_FOR
    threads: 1
    resources:
        mem_mb=memory_by("triangles", 0.035),
    shell:
        STAGE + " match {wildcards.mesh:q} {input.shell:q} {input.carried:q} {input.stones:q} {input.contacts:q} {output.match:q}" + LOG


rule limit:
    input:
        code="code/limit.txt",
        settings="limit/{analysis}/settings.json",
        shell=lambda wildcards: f"shell/{MESH_OF[wildcards.analysis]}/shell.npz",
        match=lambda wildcards: f"shell/{MESH_OF[wildcards.analysis]}/match.json",
        stones=stones_of,
    output:
        state="limit/{analysis}/limit.npz",
        record="limit/{analysis}/limit.json",
    log:
        "log/limit/{analysis}.txt",
    priority: LONG
    threads: SHARE
    resources:
        mem_mb=memory_by("triangles", 0.035),
    shell:
        STAGE + " limit {wildcards.analysis:q} {input.settings:q} {input.shell:q} {input.match:q} {input.stones:q} {output.state:q}"
        " {output.record:q}" + LOG


rule pushover:
    input:
        code="code/pushover.txt",
        settings="pushover/{analysis}/settings.json",
        shell=lambda wildcards: f"shell/{MESH_OF[wildcards.analysis]}/shell.npz",
        match=lambda wildcards: f"shell/{MESH_OF[wildcards.analysis]}/match.json",
        stones=stones_of,
    output:
        state="pushover/{analysis}/pushover.npz",
        record="pushover/{analysis}/pushover.json",
    log:
        "log/pushover/{analysis}.txt",
    priority: LONGEST
    threads: SHARE
    resources:
        mem_mb=memory_by("triangles", 0.035),
    shell:
        STAGE + " pushover {wildcards.analysis:q} {input.settings:q} {input.shell:q} {input.match:q} {input.stones:q} {output.state:q}"
        " {output.record:q}" + LOG
