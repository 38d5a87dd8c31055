!> What a run of blocks in space is made of: the hooks of dem_run.
module dem3_run
   use common_kinds, only : wp
   use common_lists, only : stop_end => dem_stop_end, stop_collapse => dem_stop_collapse, stop_left => dem_stop_left
   use common_status, only : status_ok, status_invalid_argument, status_not_finite, status_out_of_memory
   use dem_clock, only : model_clock
   use dem_energy, only : energy_terms
   use dem_joint, only : brace, free_strength => free_mortar
   use dem_rigid, only : rigid_solver, suitable_step
   use dem_run, only : any_step, model_sizes, simulation, slides_not
   use dem_tape, only : tape, loading
   use dem3_bodies, only : body, spin_of, turn_freely
   use dem3_law, only : contact_point
   use dem3_moreau, only : advance_rigid, quickest
   use dem3_model, only : advance, colour, critical_step, model_energy => energy_now, search, set_distances, &
      set_mortar, solid_model
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: solid_simulation

   type, extends(simulation) :: solid_simulation
      type(solid_model) :: model
      real(wp) :: domain = 0.0_wp               !! displacement by which a body has left the scene [m]; 0: none
   contains
      procedure :: clock => clock_of
      procedure :: solver => solver_of
      procedure :: search => find_pairs
      procedure :: stable_step
      procedure :: advance => take_steps
      procedure :: energy => energy_now
      procedure :: agitation
      procedure :: speed => greatest_speed
      procedure :: unbalanced
      procedure :: least_balanced
      procedure :: fastest
      procedure :: limits
      procedure :: mark_rest
      procedure :: stop_all
      procedure :: brace_joints
      procedure :: free_mortar
      procedure :: free_joints
      procedure :: forget_settling
      procedure :: put_down
      procedure :: sizes
      procedure :: make_room
      procedure :: walk
   end type solid_simulation

contains

   function clock_of(run) result(clock)
      class(solid_simulation), intent(inout), target :: run
      type(model_clock), pointer :: clock
      clock => run%model%model_clock
   end function clock_of

   function solver_of(run) result(solver)
      class(solid_simulation), intent(inout), target :: run
      class(rigid_solver), pointer :: solver
      solver => run%model%rigid
   end function solver_of

   subroutine find_pairs(run, first_time, status)
      class(solid_simulation), intent(inout) :: run
      logical, intent(in) :: first_time
      integer(c_int), intent(out) :: status
      integer :: k
      associate (model => run%model)
         status = status_not_finite
         do k = 1, size(model%set%item)
            if (.not. all(abs(model%set%item(k)%x) <= huge(1.0_wp))) return
         end do
         if (first_time) call set_distances(model)
         call search(model, status)
         if (status /= status_ok) return
         run%record%pairs = model%pairs
         if (first_time) call set_mortar(model)
         if (any(model%pair(:model%pairs)%lacks_memory)) status = status_out_of_memory
      end associate
   end subroutine find_pairs

   subroutine stable_step(run, stable, suitable, status)
      class(solid_simulation), intent(inout) :: run
      real(wp), intent(out) :: stable           !! [s]
      real(wp), intent(out) :: suitable         !! [s]
      integer(c_int), intent(out) :: status
      if (run%model%rigid%setting%used) then
         status = status_ok
         stable = any_step
         suitable = suitable_step(run%model%rigid, run%model%quasi_static)
      else
         call critical_step(run%model, stable, status)
         suitable = run%options%fraction * stable
      end if
   end subroutine stable_step

   subroutine take_steps(run, count, status)
      class(solid_simulation), intent(inout) :: run
      integer, intent(in) :: count
      integer(c_int), intent(out) :: status
      status = status_ok
      if (run%model%rigid%setting%used) then
         call advance_rigid(run%model, count, status)
      else
         call advance(run%model, count, run%options%threads)
      end if
      if (any(run%model%pair(:run%model%pairs)%lacks_memory)) status = status_out_of_memory
   end subroutine take_steps

   function energy_now(run) result(now)
      class(solid_simulation), intent(in) :: run
      type(energy_terms) :: now
      now = model_energy(run%model)
   end function energy_now

   !> Kinetic energy at the last forces [J]
   function agitation(run) result(energy)
      class(solid_simulation), intent(in) :: run
      real(wp) :: energy
      type(energy_terms) :: now
      now = model_energy(run%model)
      energy = now%kinetic
   end function agitation

   !> Greatest speed of a body [m/s]
   function greatest_speed(run) result(speed)
      class(solid_simulation), intent(in) :: run
      real(wp) :: speed
      speed = quickest(run%model)
   end function greatest_speed

   !> Greatest unbalanced force over weight, and moment over weight times radius
   function unbalanced(run) result(ratio)
      class(solid_simulation), intent(in) :: run
      real(wp) :: ratio
      real(wp) :: g
      integer :: k
      associate (model => run%model)
         g = max(norm2(model%gravity), 1.0e-3_wp)
         ratio = 0.0_wp
         do k = 1, size(model%set%item)
            associate (b => model%set%item(k))
               if (b%fixed) cycle
               ratio = max(ratio, norm2(b%force / b%mass + model%gravity) / g, &
                  norm2(b%moment) / (b%mass * g * b%radius))
            end associate
         end do
      end associate
   end function unbalanced

   function least_balanced(run) result(number)
      class(solid_simulation), intent(in) :: run
      integer :: number
      real(wp) :: greatest, rate
      integer :: k
      number = 0
      greatest = 0.0_wp
      do k = 1, size(run%model%set%item)
         associate (b => run%model%set%item(k))
            if (b%fixed) cycle
            rate = norm2(b%force * b%inverse_mass + run%model%gravity)
            if (rate > greatest .or. number == 0) number = k
            greatest = max(greatest, rate)
         end associate
      end do
   end function least_balanced

   function fastest(run) result(number)
      class(solid_simulation), intent(in) :: run
      integer :: number
      real(wp) :: greatest, speed
      integer :: k
      number = 0
      greatest = 0.0_wp
      do k = 1, size(run%model%set%item)
         associate (b => run%model%set%item(k))
            if (b%fixed) cycle
            speed = norm2(b%v)
            if (speed > greatest .or. number == 0) number = k
            greatest = max(greatest, speed)
         end associate
      end do
   end function fastest

   !> Has a body moved farther than what counts as collapse, or, once it is shaken, left the scene?
   subroutine limits(run, collapse)
      class(solid_simulation), intent(inout) :: run
      real(wp), intent(in) :: collapse
      integer :: k
      real(wp) :: away, turned
      logical :: gone
      associate (model => run%model, record => run%record)
         do k = 1, size(model%set%item)
            if (model%set%item(k)%fixed) cycle
            associate (b => model%set%item(k))
               away = norm2(b%x - b%rest)
               ! The trace of a rotation is 1 + 2 cos of its angle.
               turned = acos(max(-1.0_wp, min(1.0_wp, 0.5_wp * (sum(b%turn * b%rest_turn) - 1.0_wp))))
               gone = collapse > 0.0_wp .and. away > collapse
               if (gone .and. model%shaking) gone = slides_not(run%options, turned, b%rest(3) - b%x(3))
               if (gone) record%reason = stop_collapse
            end associate
            if (model%shaking .and. run%domain > 0.0_wp .and. away > run%domain) record%reason = stop_left
            if (record%reason == stop_end) cycle
            record%blamed(1) = k
            return
         end do
      end associate
   end subroutine limits

   subroutine mark_rest(run)
      class(solid_simulation), intent(inout) :: run
      integer :: k
      do k = 1, size(run%model%set%item)
         associate (b => run%model%set%item(k))
            b%rest = b%x
            b%rest_turn = b%turn
         end associate
      end do
   end subroutine mark_rest

   subroutine stop_all(run)
      class(solid_simulation), intent(inout) :: run
      integer :: k
      do k = 1, size(run%model%set%item)
         run%model%set%item(k)%v = 0.0_wp
         run%model%set%item(k)%swing = 0.0_wp
      end do
   end subroutine stop_all

   subroutine brace_joints(run, braced, status)
      class(solid_simulation), intent(inout) :: run
      logical, intent(out) :: braced
      integer(c_int), intent(out) :: status
      call brace(run%model%law, run%options%settle_damping, run%model%own_law, braced, status)
   end subroutine brace_joints

   subroutine free_mortar(run)
      class(solid_simulation), intent(inout) :: run
      call free_strength(run%model%law, run%model%own_law)
   end subroutine free_mortar

   subroutine free_joints(run)
      class(solid_simulation), intent(inout) :: run
      call move_alloc(run%model%own_law, run%model%law)
   end subroutine free_joints

   subroutine forget_settling(run)
      class(solid_simulation), intent(inout) :: run
      integer :: k, n
      associate (model => run%model)
         do k = 1, model%pairs
            associate (pair => model%pair(k))
               pair%friction_loss = 0.0_wp
               pair%damping_loss = 0.0_wp
               pair%support_work = 0.0_wp
               do n = 1, pair%points
                  pair%point(n)%dash_n = 0.0_wp
                  pair%point(n)%dash_s = 0.0_wp
                  pair%point(n)%force = pair%point(n)%force - pair%point(n)%dash
                  pair%point(n)%dash = 0.0_wp
               end do
            end associate
         end do
         model%dowels%friction_loss = 0.0_wp
         model%dowels%damping_loss = 0.0_wp
         model%dowels%support_work = 0.0_wp
         do k = 1, size(model%dowels)
            model%dowels(k)%dash = 0.0_wp
         end do
         model%lost = 0.0_wp
         model%support_work = 0.0_wp
         model%set%item%work = 0.0_wp
         model%set%item%bounces = 0
         model%set%item%airborne = 0.0_wp
      end associate
   end subroutine forget_settling

   subroutine put_down(run)
      class(solid_simulation), intent(inout) :: run
      integer :: k
      real(wp) :: half
      type(body) :: b
      associate (model => run%model, record => run%record, n => run%record%points)
         half = 0.5_wp * model%drift
         do k = 1, size(model%set%item)
            b = model%set%item(k)
            if (.not. b%fixed) call turn_freely(b, -model%drift)
            record%place(:, k, n) = b%x - model%drift * b%v
            record%turn(:, :, k, n) = b%turn
            record%rate(:, k, n) = 0.0_wp
            if (b%fixed) cycle
            record%rate(1:3, k, n) = b%v - half * (b%force / b%mass + model%pull)
            record%rate(4:6, k, n) = spin_of(b, b%swing - half * b%moment)
         end do
      end associate
   end subroutine put_down

   function sizes(run) result(told)
      class(solid_simulation), intent(in) :: run
      integer(c_int64_t) :: told(model_sizes)
      type(body) :: one
      type(contact_point) :: point
      told = int([storage_size(one), storage_size(point), size(run%model%set%item), size(run%model%set%parts), &
         run%model%pairs, size(run%model%dowels), 0, 0], c_int64_t)
   end function sizes

   subroutine make_room(run, sizes, most, status)
      class(solid_simulation), intent(inout) :: run
      integer(c_int64_t), intent(in) :: sizes(model_sizes)
      integer(c_int64_t), intent(in) :: most
      integer(c_int), intent(out) :: status
      integer :: failed
      status = status_invalid_argument
      if (sizes(5) < 0 .or. sizes(5) > most .or. sizes(6) /= size(run%model%dowels)) return
      allocate (run%model%pair(sizes(5)), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed == 0) run%model%pairs = int(sizes(5))
   end subroutine make_room

   subroutine walk(run, on, status)
      class(solid_simulation), intent(inout), target :: run
      type(tape), intent(inout) :: on
      integer(c_int), intent(out) :: status
      integer :: k, failed
      status = status_ok
      associate (model => run%model)
         call on%pass(model%set%item, storage_size(model%set%item))
         call on%pass(model%pull, storage_size(model%pull))
         call on%pass(model%pull_before, storage_size(model%pull_before))
         call on%pass(model%skin, storage_size(model%skin))
         call on%pass(model%reach, storage_size(model%reach))
         call on%pass(model%margin, storage_size(model%margin))
         call on%pass(model%far, storage_size(model%far))
         call on%pass(model%wander, storage_size(model%wander))
         call on%pass(model%lost, storage_size(model%lost))
         call on%pass(model%support_work, storage_size(model%support_work))
         call on%pass(model%dowels, storage_size(model%dowels))
         do k = 1, model%pairs
            associate (pair => model%pair(k))
               call on%pass(pair%part, storage_size(pair%part))
               call on%pass(pair%law, storage_size(pair%law))
               call on%pass(pair%points, storage_size(pair%points))
               call on%pass(pair%reference, storage_size(pair%reference))
               call on%pass(pair%marks, storage_size(pair%marks))
               call on%pass(pair%place, storage_size(pair%place))
               call on%pass(pair%turn, storage_size(pair%turn))
               call on%pass(pair%friction_loss, storage_size(pair%friction_loss))
               call on%pass(pair%damping_loss, storage_size(pair%damping_loss))
               call on%pass(pair%support_work, storage_size(pair%support_work))
               if (on%mode == loading) then
                  status = status_invalid_argument
                  if (on%short .or. pair%points < 0 .or. pair%points > size(on%bytes)) return
                  allocate (pair%point(pair%points), stat=failed)
                  status = merge(status_ok, status_out_of_memory, failed == 0)
                  if (failed /= 0) return
               end if
               if (allocated(pair%point)) call on%pass(pair%point, storage_size(pair%point))
            end associate
         end do
         if (on%mode == loading .and. .not. on%short) call colour(model, status)
      end associate
   end subroutine walk

end module dem3_run
