# What people and programs read.


rule compare:
    input:
        code="code/compare.txt",
        plan="plan.json",
        sizes=expand("geometry/{geometry}/{part}.npz", geometry=GEOMETRIES, part=["assemblage", "contacts"]),
        shells=expand("shell/{mesh}/{part}", mesh=SHELLS, part=["shell.npz", "match.json"]),
        fits=expand("geometry/{geometry}/fit.json", geometry=set(SHELLS.values()) if config["drawing"] else []),
        records=files_of(ANALYSES, "json"),
        states=files_of(ANALYSES, "npz"),
        halved=expand("curve/{analysis}/halved.npz", analysis=HALVED),
        movements=expand("movement/{movement}/movement.json", movement=MOVEMENTS),
        samples=expand("sample/{sample}/records.json", sample=SAMPLES),
    output:
        **{"summary": "summary.json", "table": "table.csv"} | ({"samples": "samples.csv"} if SAMPLES else {}),
    log:
        "log/compare/all.txt",
    threads: 1
    resources:
        mem_mb=MEMORY,
    shell:
        STAGE + " compare all {input.plan:q} {output:q}" + LOG


for number, geometry in enumerate(GEOMETRIES):

    rule:
        name:
            f"report_{number}" if number else "report"
        input:
            code="code/report.txt",
            plan="plan.json",
            case="as-run.toml",
            summary="summary.json",
            assemblage=f"geometry/{geometry}/assemblage.npz",
            contacts=f"geometry/{geometry}/contacts.npz",
            shells=[f"shell/{mesh}/shell.npz" for mesh, place in SHELLS.items() if place == geometry],
            states=files_of([a for a in ANALYSES if a["geometry"] == geometry], "npz"),
            movements=[f"movement/{name}/{part}.npz" for name, place in MOVEMENTS.items() if place == geometry for part in ("assemblage", "contacts", "movement")],
        output:
            html=report_of(geometry),
            mechanisms=[
                f"rigid/{a['name']}/{part}.vtu"
                for a in ANALYSES
                if a["geometry"] == geometry and a["kind"] == "rigid"
                for part in ("mechanism", "joints")
            ],
        log:
            f"log/report/{number}.txt",
        threads: 1
        resources:
            mem_mb=MEMORY,
        shell:
            STAGE + " report {output.html:q} {input.plan:q} {input.summary:q} {input.assemblage:q} {input.contacts:q} {output.html:q}" + LOG
