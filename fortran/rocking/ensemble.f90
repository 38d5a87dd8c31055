!> Many independent responses at once: every pair of structure and motion is one run.
module rocking_ensemble
   use common_kinds, only : wp
   use common_cancel, only : cancel_requested
   use common_lists, only : body_arch => rocking_body_arch, body_block => rocking_body_block, &
      body_restrained => rocking_body_restrained, body_soft_base => rocking_body_soft_base, &
      body_stack => rocking_body_stack, body_table => rocking_body_table, body_watched => rocking_body_watched
   use common_motion_set, only : motion_set, motion_signal
   use common_signal, only : signal
   use common_status, only : status_ok, status_bad_index, status_cancelled, status_invalid_argument, &
      status_not_ready, status_out_of_memory
   use rocking_arch_rocker, only : arch_rocker, arch_rocker_new
   use rocking_block_rocker, only : block_rocker, block_rocker_new
   use rocking_restrained, only : restrain_body
   use rocking_response, only : find_response, response, response_options
   use rocking_rocker, only : rocker
   use rocking_soft_base_response, only : soft_base_body, soft_base_body_new, soft_base_respond
   use rocking_stack_response, only : stack_body, stack_body_new, stack_respond
   use rocking_table_rocker, only : table_rocker, table_rocker_new
   use rocking_watch, only : joint_watch_new
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: body_data, body_list, list_body, run_ensemble

   !> Runs of a structure that repay the bounds of its joints
   integer, parameter :: many_runs = 16

   !> Room for one structure of any kind: of one coordinate, a block on a compliant base, or two blocks
   type :: any_body
      class(rocker), allocatable :: model
      type(soft_base_body), allocatable :: soft
      type(stack_body), allocatable :: pair
      integer(c_int) :: status = status_ok
   end type any_body

   !> A rocking structure as it was given: its kind and its flat parameter list
   type :: body_data
      integer(c_int) :: kind = 0
      real(wp), allocatable :: parameters(:)
   end type body_data

   type :: body_list
      type(body_data), allocatable :: item(:)
   end type body_list

contains

   !> A rocking structure from its flat parameter list
   recursive subroutine make_body(kind, parameters, body, status)
      integer(c_int), intent(in) :: kind
      real(wp), intent(in) :: parameters(:)
      class(rocker), allocatable, intent(out) :: body
      integer(c_int), intent(out) :: status
      type(arch_rocker), allocatable :: arch
      type(block_rocker), allocatable :: stone
      type(table_rocker), allocatable :: tabulated
      integer :: last, restraints, stat

      select case (kind)
      case (body_arch)
         allocate (arch, stat=stat)
         if (stat /= 0) then
            status = status_out_of_memory
            return
         end if
         call arch_rocker_new(parameters, arch, status)
         call move_alloc(arch, body)
      case (body_block)
         allocate (stone, stat=stat)
         if (stat /= 0) then
            status = status_out_of_memory
            return
         end if
         call block_rocker_new(parameters, stone, status)
         call move_alloc(stone, body)
      case (body_table)
         allocate (tabulated, stat=stat)
         if (stat /= 0) then
            status = status_out_of_memory
            return
         end if
         call table_rocker_new(parameters, tabulated, status)
         call move_alloc(tabulated, body)
      case (body_restrained)
         ! kind and number of the parameters of what is restrained, these, and the restraints
         status = status_invalid_argument
         if (size(parameters) < 2) return
         if (nint(parameters(1)) == body_restrained) return
         last = 2 + nint(parameters(2))
         if (last < 2 .or. last > size(parameters)) return
         call make_body(nint(parameters(1), c_int), parameters(3:last), body, status)
         if (status == status_ok) call restrain_body(body, parameters(last + 1:), status)
      case (body_watched)
         ! kind and number of the parameters of what is watched, these, and what its joints carry
         status = status_invalid_argument
         if (size(parameters) < 2) return
         if (nint(parameters(1)) == body_watched) return
         last = 2 + nint(parameters(2))
         if (last < 2 .or. last > size(parameters)) return
         call make_body(nint(parameters(1), c_int), parameters(3:last), body, status)
         if (status /= status_ok) return
         allocate (body%watch, stat=stat)
         status = status_out_of_memory
         restraints = 0
         if (allocated(body%held)) restraints = body%held%count
         if (stat == 0) call joint_watch_new(parameters(last + 1:), restraints, body%watch, status)
      case default
         status = status_invalid_argument
      end select
   end subroutine make_body

   !> A structure of any kind as it was given
   subroutine build_body(given, body)
      type(body_data), intent(in) :: given
      type(any_body), intent(out) :: body
      integer :: stat
      body%status = status_not_ready
      if (.not. allocated(given%parameters)) return
      if (given%kind == body_soft_base) then
         body%status = status_out_of_memory
         allocate (body%soft, stat=stat)
         if (stat == 0) call soft_base_body_new(given%parameters, body%soft, body%status)
      else if (given%kind == body_stack) then
         body%status = status_out_of_memory
         allocate (body%pair, stat=stat)
         if (stat == 0) call stack_body_new(given%parameters, body%pair, body%status)
      else
         call make_body(given%kind, given%parameters, body%model, body%status)
      end if
   end subroutine build_body

   !> Structure `number` of a list, of one coordinate
   subroutine list_body(list, number, body, status)
      type(body_list), intent(in) :: list
      integer(c_int), intent(in) :: number           !! 1-based
      class(rocker), allocatable, intent(out) :: body
      integer(c_int), intent(out) :: status          !! not_ready where it was not given yet
      status = status_bad_index
      if (number < 1 .or. number > size(list%item)) return
      status = status_not_ready
      if (.not. allocated(list%item(number)%parameters)) return
      call make_body(list%item(number)%kind, list%item(number)%parameters, body, status)
   end subroutine list_body

   !> Run all members; the result of a member does not depend on the others or on the threads
   subroutine run_ensemble(bodies, set, run_body, run_motion, run_scale, options, threads, &
                           answers, run_status, status)
      type(body_list), intent(in) :: bodies
      type(motion_set), intent(in), target :: set
      integer(c_int), intent(in) :: run_body(:)       !! (nrun), 1-based
      integer(c_int), intent(in) :: run_motion(:)     !! (nrun), 1-based
      real(wp), intent(in) :: run_scale(:)            !! (nrun)
      type(response_options), intent(in) :: options(:)  !! (nrun)
      integer(c_int), intent(in) :: threads
      type(response), intent(out) :: answers(:)
      integer(c_int), intent(out) :: run_status(:)    !! per member; cancelled members were not run
      integer(c_int), intent(out) :: status
      type(any_body), allocatable :: built(:)
      integer, allocatable :: runs(:)  ! of each structure
      type(signal) :: ground
      integer :: k, stat

      run_status = status_cancelled
      status = status_bad_index
      if (any(run_body < 1) .or. any(run_body > size(bodies%item))) return
      allocate (built(size(bodies%item)), runs(size(bodies%item)), stat=stat)
      if (stat /= 0) then
         status = status_out_of_memory
         return
      end if
      runs = 0
      do k = 1, size(run_body)
         runs(run_body(k)) = runs(run_body(k)) + 1
      end do
      !$omp parallel default(none) num_threads(threads) private(k, ground) &
      !$omp shared(bodies, set, runs, run_body, run_motion, run_scale, options, answers, run_status, built)
      !$omp do schedule(dynamic)
      do k = 1, size(built)
         call build_body(bodies%item(k), built(k))
         if (built(k)%status /= status_ok .or. runs(k) < many_runs) cycle
         if (allocated(built(k)%model)) call built(k)%model%bound_joints(runs(k), built(k)%status)
      end do
      !$omp end do
      !$omp do schedule(dynamic)
      do k = 1, size(run_body)
         if (cancel_requested()) cycle
         run_status(k) = built(run_body(k))%status
         if (run_status(k) /= status_ok) cycle
         call motion_signal(set, run_motion(k), run_scale(k), ground, run_status(k))
         if (run_status(k) /= status_ok) cycle
         associate (body => built(run_body(k)))
            if (allocated(body%soft)) then
               call soft_base_respond(body%soft, ground, options(k), answers(k), run_status(k))
            else if (allocated(body%pair)) then
               call stack_respond(body%pair, ground, options(k), answers(k), run_status(k))
            else
               call find_response(body%model, ground, options(k), answers(k), run_status(k))
            end if
         end associate
      end do
      !$omp end do
      !$omp end parallel
      status = merge(status_cancelled, status_ok, any(run_status == status_cancelled))
      if (any(run_status == status_out_of_memory)) status = status_out_of_memory
   end subroutine run_ensemble

end module rocking_ensemble
