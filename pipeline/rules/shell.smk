# The homogenised shell: panels of a drawing, mesh, gate, and one limit analysis or capacity curve for each load and combination
# of swept values.

if config["drawing"]:

    rule panels:
        input:
            settings="geometry/{geometry}/settings.json",
            assemblage="geometry/{geometry}/assemblage.npz",
            sources=sources("derive", "bond", "config/plan.py", "io/building_json.py"),
        output:
            building="geometry/{geometry}/building.json",
            fitted="geometry/{geometry}/fitted.npz",
            fit="geometry/{geometry}/fit.json",
        shell:
            STAGE + " panels {wildcards.geometry:q} {input.settings:q} {input.assemblage:q} {output.building:q} {output.fitted:q}"
            " {output.fit:q}"


rule shell:
    input:
        settings="shell/{mesh}/settings.json",
        building=lambda wildcards: f"geometry/{SHELLS[wildcards.mesh]}/building.json",
        sources=sources(
            "shell_mesh/shell.py",
            "shell_mesh/midplanes.py",
            "shell_mesh/self_weight.py",
            "shell_mesh/subdivision.py",
            "bond",
            "io/building_json.py",
            "io/shell_vtu.py",
        ),
    output:
        shell="shell/{mesh}/shell.npz",
    shell:
        STAGE + " shell {wildcards.mesh:q} {input.settings:q} {input.building:q} {output.shell:q}"


rule match:
    input:
        shell="shell/{mesh}/shell.npz",
        stones=lambda wildcards: f"geometry/{SHELLS[wildcards.mesh]}/{FITTED}",
        contacts=lambda wildcards: f"geometry/{SHELLS[wildcards.mesh]}/contacts.npz",
        sources=sources("match.py", "geometry/locate.py", "shell_mesh/midplanes.py", "bond"),
    output:
        match="shell/{mesh}/match.json",
    shell:
        STAGE + " match {wildcards.mesh:q} {input.shell:q} {input.stones:q} {input.contacts:q} {output.match:q}"


rule limit:
    input:
        settings="limit/{analysis}/settings.json",
        shell=lambda wildcards: f"shell/{MESH_OF[wildcards.analysis]}/shell.npz",
        match=lambda wildcards: f"shell/{MESH_OF[wildcards.analysis]}/match.json",
        sources=sources("homogenised_shell", "conic", "config/plan.py", "config/units.py", "io/records.py"),
    output:
        state="limit/{analysis}/limit.npz",
        record="limit/{analysis}/limit.json",
    shell:
        STAGE + " limit {wildcards.analysis:q} {input.settings:q} {input.shell:q} {input.match:q} {output.state:q} {output.record:q}"


rule pushover:
    input:
        settings="pushover/{analysis}/settings.json",
        shell=lambda wildcards: f"shell/{MESH_OF[wildcards.analysis]}/shell.npz",
        match=lambda wildcards: f"shell/{MESH_OF[wildcards.analysis]}/match.json",
        sources=sources("homogenised_shell", "conic", "config/plan.py", "config/units.py", "io/records.py"),
    output:
        state="pushover/{analysis}/pushover.npz",
        record="pushover/{analysis}/pushover.json",
    shell:
        STAGE + " pushover {wildcards.analysis:q} {input.settings:q} {input.shell:q} {input.match:q} {output.state:q}"
        " {output.record:q}"
