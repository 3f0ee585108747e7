//! Made by `make bindings` from the header of Ipopt 3.14.

pub type ipnumber = f64;
pub type ipindex = std::ffi::c_int;
pub const Solve_Succeeded: ApplicationReturnStatus = 0;
pub const Solved_To_Acceptable_Level: ApplicationReturnStatus = 1;
pub const Infeasible_Problem_Detected: ApplicationReturnStatus = 2;
pub const Search_Direction_Becomes_Too_Small: ApplicationReturnStatus = 3;
pub const Diverging_Iterates: ApplicationReturnStatus = 4;
pub const User_Requested_Stop: ApplicationReturnStatus = 5;
pub const Feasible_Point_Found: ApplicationReturnStatus = 6;
pub const Maximum_Iterations_Exceeded: ApplicationReturnStatus = -1;
pub const Restoration_Failed: ApplicationReturnStatus = -2;
pub const Error_In_Step_Computation: ApplicationReturnStatus = -3;
pub const Maximum_CpuTime_Exceeded: ApplicationReturnStatus = -4;
pub const Maximum_WallTime_Exceeded: ApplicationReturnStatus = -5;
pub const Not_Enough_Degrees_Of_Freedom: ApplicationReturnStatus = -10;
pub const Invalid_Problem_Definition: ApplicationReturnStatus = -11;
pub const Invalid_Option: ApplicationReturnStatus = -12;
pub const Invalid_Number_Detected: ApplicationReturnStatus = -13;
pub const Unrecoverable_Exception: ApplicationReturnStatus = -100;
pub const NonIpopt_Exception_Thrown: ApplicationReturnStatus = -101;
pub const Insufficient_Memory: ApplicationReturnStatus = -102;
pub const Internal_Error: ApplicationReturnStatus = -199;
pub type ApplicationReturnStatus = std::ffi::c_int;
#[repr(C)]
#[derive(Debug)]
pub struct IpoptProblemInfo {
    _unused: [u8; 0],
}
pub type IpoptProblem = *mut IpoptProblemInfo;
pub type Bool = bool;
pub type UserDataPtr = *mut std::ffi::c_void;
pub type Eval_F_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: ipindex,
        x: *mut ipnumber,
        new_x: bool,
        obj_value: *mut ipnumber,
        user_data: UserDataPtr,
    ) -> bool,
>;
pub type Eval_Grad_F_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: ipindex,
        x: *mut ipnumber,
        new_x: bool,
        grad_f: *mut ipnumber,
        user_data: UserDataPtr,
    ) -> bool,
>;
pub type Eval_G_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: ipindex,
        x: *mut ipnumber,
        new_x: bool,
        m: ipindex,
        g: *mut ipnumber,
        user_data: UserDataPtr,
    ) -> bool,
>;
pub type Eval_Jac_G_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: ipindex,
        x: *mut ipnumber,
        new_x: bool,
        m: ipindex,
        nele_jac: ipindex,
        iRow: *mut ipindex,
        jCol: *mut ipindex,
        values: *mut ipnumber,
        user_data: UserDataPtr,
    ) -> bool,
>;
pub type Eval_H_CB = ::std::option::Option<
    unsafe extern "C" fn(
        n: ipindex,
        x: *mut ipnumber,
        new_x: bool,
        obj_factor: ipnumber,
        m: ipindex,
        lambda: *mut ipnumber,
        new_lambda: bool,
        nele_hess: ipindex,
        iRow: *mut ipindex,
        jCol: *mut ipindex,
        values: *mut ipnumber,
        user_data: UserDataPtr,
    ) -> bool,
>;
pub type Intermediate_CB = ::std::option::Option<
    unsafe extern "C" fn(
        alg_mod: ipindex,
        iter_count: ipindex,
        obj_value: ipnumber,
        inf_pr: ipnumber,
        inf_du: ipnumber,
        mu: ipnumber,
        d_norm: ipnumber,
        regularization_size: ipnumber,
        alpha_du: ipnumber,
        alpha_pr: ipnumber,
        ls_trials: ipindex,
        user_data: UserDataPtr,
    ) -> bool,
>;
unsafe extern "C" {
    pub fn CreateIpoptProblem(
        n: ipindex,
        x_L: *mut ipnumber,
        x_U: *mut ipnumber,
        m: ipindex,
        g_L: *mut ipnumber,
        g_U: *mut ipnumber,
        nele_jac: ipindex,
        nele_hess: ipindex,
        index_style: ipindex,
        eval_f: Eval_F_CB,
        eval_g: Eval_G_CB,
        eval_grad_f: Eval_Grad_F_CB,
        eval_jac_g: Eval_Jac_G_CB,
        eval_h: Eval_H_CB,
    ) -> IpoptProblem;
    pub fn FreeIpoptProblem(ipopt_problem: IpoptProblem);
    pub fn AddIpoptStrOption(
        ipopt_problem: IpoptProblem,
        keyword: *mut std::ffi::c_char,
        val: *mut std::ffi::c_char,
    ) -> bool;
    pub fn AddIpoptNumOption(
        ipopt_problem: IpoptProblem,
        keyword: *mut std::ffi::c_char,
        val: ipnumber,
    ) -> bool;
    pub fn AddIpoptIntOption(
        ipopt_problem: IpoptProblem,
        keyword: *mut std::ffi::c_char,
        val: ipindex,
    ) -> bool;
    pub fn SetIntermediateCallback(
        ipopt_problem: IpoptProblem,
        intermediate_cb: Intermediate_CB,
    ) -> bool;
    pub fn IpoptSolve(
        ipopt_problem: IpoptProblem,
        x: *mut ipnumber,
        g: *mut ipnumber,
        obj_val: *mut ipnumber,
        mult_g: *mut ipnumber,
        mult_x_L: *mut ipnumber,
        mult_x_U: *mut ipnumber,
        user_data: UserDataPtr,
    ) -> ApplicationReturnStatus;
}
