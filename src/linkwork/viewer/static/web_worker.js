"use strict";(()=>{function*w(e){let t=new DataView(e),s=e.byteLength-22,n=t.getUint32(s+16,!0);for(let i=t.getUint16(s+10,!0);i>0;i-=1){let[o,l]=[t.getUint32(n+24,!0),t.getUint16(n+28,!0)],a=t.getUint32(n+42,!0),c=a+30+t.getUint16(a+26,!0)+t.getUint16(a+28,!0);yield{name:new TextDecoder().decode(new Uint8Array(e,n+46,l)),content:new Uint8Array(e,c,o)},n+=46+l+t.getUint16(n+30,!0)+t.getUint16(n+32,!0)}}var d="https://linkwork.invalid/",h="/lib/python3.13/site-packages",F=["python_stdlib.zip","site.zip"],y="/tmp/site.zip",g="/tmp/prepared.zip",k=3e3,A=`
from pathlib import Path

from linkwork_page import take, tell, turn
from pyodide.ffi import can_run_sync, run_sync

from linkwork.api import example_text, loads
from linkwork.viewer.live.browser_desk import BrowserDesk
from linkwork.viewer.live.bytecode import with_bytecode

STDLIB = Path("/lib/python313.zip")


def pause():
    if can_run_sync():
        run_sync(turn())


desk = BrowserDesk(loads, example_text, tell, take, pause)
begin, work = desk.begin, desk.work
steps = {
    "python_stdlib.zip": with_bytecode(STDLIB, STDLIB, Path("${g}")),
    "site.zip": with_bytecode(Path("${y}"), Path("${h}"), Path("${g}")),
}


def prepare(name):
    return next(steps[name], 0) is None
`,P=[],m=null,p=!1;self.onmessage=({data:e})=>{typeof e=="string"?(P.push(e),b()):U(e).catch(t=>self.postMessage({failed:String(t)}))};async function U({engine:e,files:t,fragment:s,kept:n,prepare:i}){u("Starting Python …"),self.fetch=r=>Promise.resolve(_(String(r),t));let o=await loadPyodide({indexURL:d,lockFileContents:e.lock,packageBaseUrl:d});u("Loading the solver …");for(let{name:r,content:S}of w(t["site.zip"])){let f=`${h}/${r}`;o.FS.mkdirTree(f.slice(0,f.lastIndexOf("/"))),o.FS.writeFile(f,S,{canOwn:!0})}i&&o.FS.writeFile(y,new Uint8Array(t["site.zip"]),{canOwn:!0});for(let r of Object.keys(t))delete t[r];let l=()=>P.splice(0);o.registerJsModule("linkwork_page",{take:l,tell:r=>self.postMessage(r),turn:v}),await o.runPythonAsync(A),u("Solving …");let[a,c]=[o.globals.get("begin"),o.globals.get("work")];a(s,n?.name??"",n?.saved??"",n?.text??""),m="Suspending"in WebAssembly?()=>c.callPromising():()=>Promise.resolve(c()),await b(),i&&E(o)}function E(e){let t=e.globals.get("prepare"),s=[...F],n=()=>{let[i]=s;if(i===void 0)e.FS.unlink(y);else if(p)setTimeout(n,k);else{if(!t(i)){let o=e.FS.readFile(g).buffer;e.FS.unlink(g),self.postMessage({prepared:{[i]:o}},[o]),s.shift()}setTimeout(n)}};setTimeout(n,k)}async function b(){if(!(p||m===null)){p=!0;try{for(;await m();)await v()}catch(e){self.postMessage({failed:String(e)})}p=!1}}function v(){return new Promise(e=>{let{port1:t,port2:s}=new MessageChannel;t.onmessage=()=>{t.close(),e()},s.postMessage(null)})}function _(e,t){let s=e.slice(d.length),n=s.endsWith(".wasm")?"application/wasm":"application/octet-stream",i=e.startsWith(d)?t[s]:void 0;return i?new Response(i,{headers:{"content-type":n}}):new Response(null,{status:404})}function u(e){self.postMessage({doing:e})}})();
